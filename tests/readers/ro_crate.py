"""Validates an archive as a Process Run Crate, without the network, and lists its actions.

usage: ro_crate.py DIRECTORY
"""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import rocrate
from rocrate.rocrate import ROCrate
from rocrate_validator import services
from rocrate_validator.models import Severity, ValidationSettings
from rocrate_validator.utils.http import HttpRequester

# The package has RO-Crate's terms.
TERMS = (Path(rocrate.__file__).parent / "data/ro-crate.jsonld").read_text()


def get(_, url, **_options):
    found = url == "https://w3id.org/ro/crate/1.2/context"
    return SimpleNamespace(
        status_code=200 if found else 504,
        ok=found,
        text=TERMS,
        headers={"Content-Type": "application/ld+json"},
        json=lambda: json.loads(TERMS),
        raise_for_status=lambda: None,
        from_cache=True,
    )


HttpRequester.get = get


def issues(folder, profile):
    settings = ValidationSettings(
        rocrate_uri=folder,
        profile_identifier=profile,
        requirement_severity=Severity.REQUIRED,
        # The profile of runs is written for RO-Crate 1.1; the crate follows 1.2, which is validated by itself.
        enable_profile_inheritance=False,
        offline=True,
    )
    return [f"{profile}: {issue.message}" for issue in services.validate(settings).get_issues()]


folder = sys.argv[1]
found = [issue for profile in ("ro-crate-1.2", "process-run-crate-0.5") for issue in issues(folder, profile)]
for entity in ROCrate(folder).contextual_entities:
    if entity.type == "CreateAction":
        print(entity["instrument"]["softwareVersion"], entity["name"])
print(*found, sep="\n", file=sys.stderr)
sys.exit(bool(found))
