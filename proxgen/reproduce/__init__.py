"""`proxgen reproduce`: the paper's experiments, claim by claim, and what proxgen adds to them."""
