"""Motion PCA: pose coordinates, the fit, and the model file ([PC] section 4.1)."""
