"""What needs a process or threads: Ctrl-C, other threads, and Python without NumPy."""

import signal
import subprocess
import sys
import threading

import pytest

import toprise

#: A run of hours.
ENDLESS = 'toprise.run("frictionless", {"stop.duration": 3600, "integrator.relative_tolerance": 1e-14})'


def python(program, **options):
    return subprocess.Popen(
        [sys.executable, "-c", "import toprise\n" + program],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent otherwise there")
@pytest.mark.parametrize(
    "long",
    [
        ENDLESS,
        'toprise.diff("frictionless", toprise.Scenario("frictionless", {"stop.duration": 3600}))',
        'toprise.explain(toprise.Scenario("frictionless", {"stop.duration": 3600}))',
    ],
)
def test_ctrl_c_ends_what_takes_long(long):
    process = python(
        f"try:\n  print('begun', flush=True)\n  {long}\nexcept KeyboardInterrupt:\n  print('ended')"
    )
    assert process.stdout.readline() == "begun\n"
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(0.5)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=60)
    assert (output, errors, process.returncode) == ("ended\n", "", 0)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="threads are counted in /proc")
@pytest.mark.parametrize(
    "long",
    [
        'toprise.diff("frictionless", toprise.Scenario("frictionless", {"stop.duration": 3600}))',
        'toprise.explain(toprise.Scenario("frictionless", {"stop.duration": 3600}))',
    ],
    ids=["diff", "explain"],
)
def test_nothing_is_computed_any_more_after_ctrl_c(long):
    process = python(
        "import os, time\n"
        "threads = lambda: len(os.listdir('/proc/self/task'))\n"
        "before = threads()\n"
        f"try:\n  print('begun', flush=True)\n  {long}\nexcept KeyboardInterrupt:\n  pass\n"
        "while threads() > before: time.sleep(0.01)\n"
        "print('ended')"
    )
    assert process.stdout.readline() == "begun\n"
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(0.5)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=60)
    assert (output, errors) == ("ended\n", "")


def test_other_threads_run_meanwhile():
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.wait(0.001):
            counted += 1

    counter = threading.Thread(target=count)
    counter.start()
    toprise.run("paper", topics=["/events"])
    done.set()
    counter.join()
    assert counted > 10


def test_threads_may_run_at_once():
    digests = []
    runs = [
        threading.Thread(
            target=lambda: digests.append(
                toprise.run("paper", {"stop.duration": 1.0}).content_digest
            )
        )
        for _ in range(4)
    ]
    for run in runs:
        run.start()
    for run in runs:
        run.join()
    assert len(digests) == 4 and len(set(digests)) == 1


def test_nothing_is_needed_but_python():
    process = python(
        "import sys\n"
        "run = toprise.run('paper', {'stop.duration': 0.01})\n"
        "repr(run), repr(run.events), run.events._repr_html_(), toprise.diff(run, run, integration_error=False)\n"
        "assert not {'numpy', 'pyarrow', 'polars', 'pandas'} & set(sys.modules)\n"
        "sys.modules['numpy'] = None\n"
        "try:\n  run.events.numpy('time')\nexcept ImportError:\n  print('refused')\n"
    )
    output, errors = process.communicate(timeout=60)
    assert (output, errors) == ("refused\n", "")
