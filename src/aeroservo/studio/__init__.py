"""The studio: a model file edited in the browser, analysed and simulated by Python behind it, on 127.0.0.1 only."""
