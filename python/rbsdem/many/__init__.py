"""Many runs: columns under ground motions at many scales, with measures of each run.

`rbsdem.ensemble` runs them and returns an `Ensemble`. On it stand incremental dynamic analysis,
stripes, and their fragility curves.
"""
