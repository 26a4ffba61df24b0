"""The session: document, history, files and the solver behind them; no Qt."""
