"""Studies: questions that take several analyses to answer."""
