"""Report of the everyday study: the experiment, and the table of its scenes."""
