"""A cable scene compiled into a model: degrees of freedom, elements, ties, what its frames mean."""
