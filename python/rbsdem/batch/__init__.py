"""Many runs: plan, workers, store."""
