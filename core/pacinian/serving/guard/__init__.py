"""The guard process: it alone has the device, and lets frames through only while they are permitted and fresh."""
