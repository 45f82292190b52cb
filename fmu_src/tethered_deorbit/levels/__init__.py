"""How closely a tow is followed, where not every vibration of its line is: one file for each level of detail."""
