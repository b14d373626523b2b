# %% [markdown]
# # How does a spinning top stand up?
# Run this file as a script, or cell by cell in an editor that supports `# %%`.

# %%
import matplotlib.pyplot as plt

import toprise

run = toprise.run("paper")
print(run.outcome)
run["/top/state"]

# %% [markdown]
# θ oscillates (nutation) while it decreases. `run.nutations` has the averages over each nutation.

# %%
state, nutations = run["/top/state"], run.nutations
figure, (top, bottom) = plt.subplots(2, sharex=True)
top.plot(state.numpy("time"), state.numpy("theta"), linewidth=0.3)
top.plot(nutations.numpy("time"), nutations.numpy("theta_mean"), "--")
top.set_ylabel("θ, rad")

# %% [markdown]
# Friction makes φ̇ exceed the slow rate of regular precession. While φ̇ is between the slow and the fast rate, the top rises.

# %%
regular = run["/top/precession"]
bottom.plot(nutations.numpy("time"), nutations.numpy("phi_dot_mean"), label="φ̇, mean over a nutation")
bottom.plot(regular.numpy("time"), regular.numpy("slow_root"), "--", label="slow regular precession")
bottom.set_xlabel("t, s")
bottom.set_ylabel("rad/s")
bottom.set_ylim(0, 6)
bottom.legend()
figure.savefig("rise.png")

# %% [markdown]
# Compare with the full friction torque (the paper omits a component).

# %%
report = toprise.diff(run, "full-coulomb")
print(report.summary)

# %% [markdown]
# Halve the friction: does the rise take twice as long? Then vary the spin, too.

# %%
for k in (0.03, 0.015):
    print(k, toprise.outcome("paper", {"friction.k": k})["rise_time"], "s")

# %%
spec = {
    "bases": ["paper"],
    "set": {"integrator.relative_tolerance": 1e-9, "integrator.absolute_tolerance": 1e-9},
    "over": {"friction.k": "0.02..0.08/7log", "initial.psi_dot": "100..180/5"},
}
print(toprise.sweep(spec, "map.parquet", progress=True))

# %%
toprise.map("map.parquet", "friction_k", "initial_psi_dot", width=130).save("map.png")
