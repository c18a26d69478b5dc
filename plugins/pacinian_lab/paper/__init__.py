"""The paper that Pacinian grew from (Hasegawa and Shinoda), reproduced: its experiment and its figures."""
