"""Our own models, as far as the master knows them: see `dcone_cosim.build`, the one door to them."""
