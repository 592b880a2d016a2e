"""Time histories: compiled multi-rate stepping of any aeroelastic model, its servo, controller and weather."""
