"""Real devices: descriptions, calibration and USB access."""
