"""What the simulation is for: the numbers that size the hardware.

`dcone size SCENE` asks of a tow how thick its line must be, and what governs that; `dcone size --debris` proposes net,
bullets, tether and shot for a debris and writes the scene that tests them; `dcone size --paper` rebuilds the paper's
mass budgets. Formulas are in `orbital` (`tethers`, `netting`, `materials`); here is what joins them to runs.

Checked  tests/sizing
"""
