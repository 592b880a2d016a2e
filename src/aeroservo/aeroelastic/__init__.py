"""Analyses of an AeroelasticModel: statics, flutter, linear systems."""
