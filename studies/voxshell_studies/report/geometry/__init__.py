"""Report of the geometry study: the experiment, with verdicts on pairs and on costs in files of their own."""
