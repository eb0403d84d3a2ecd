"""Advice: what the format allows but is usually a mistake, with codes of this parser (EU-DIA-006).

Its functions get the robot as read, the one built from it, a closed configuration q (nq,), and where to report.
"""
