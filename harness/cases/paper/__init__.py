"""The paper's experiments and the questions they leave: what its rig and its sensors would have shown, computed."""
