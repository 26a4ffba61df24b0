"""Cases with exact or published solutions, and the program's results for them."""
