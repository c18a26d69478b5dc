"""The paper that Pacinian grew from (Hasegawa and Shinoda), reproduced: its experiment and its figures.

experiment.py  section 5: two regions, two arrangements, four patterns; singular values of B and their cut
fourier.py     section 3: the image by the inverse Fourier transform
focus.py       width of the focus of AUTD units (Figure 3)
force.py       force of a focus, compared with the measured ones
figures.py     the figures
panels.py      their parts: maps, layouts, colour bar
report.py      all results as one object; notes on differences
tables.py      results in a terminal
"""
