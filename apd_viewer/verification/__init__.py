"""Cases with exact or published answers, and the program's answers to them."""
