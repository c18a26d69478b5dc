"""From a scene to samples: what is near, touched, resolved and felt."""
