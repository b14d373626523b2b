"""Points of SciPy's unscrambled Sobol sequence, for tests of `toprise sweep --sample --method sobol`.

python3 sobol.py > sobol.json   (written with SciPy 1.17.1)
"""

import json

import scipy
from scipy.stats import qmc

DIMENSIONS = 64
ROWS = [*range(16), 1000, 4095, 65535, 65536, 100_000, 1_048_575]

points = {}
for row in ROWS:
    sampler = qmc.Sobol(DIMENSIONS, scramble=False)
    if row:
        sampler.fast_forward(row)
    points[row] = sampler.random(1)[0].tolist()
print(json.dumps({"scipy": scipy.__version__, "points": points}))
