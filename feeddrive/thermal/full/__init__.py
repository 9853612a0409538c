"""The full heat model: finite volumes of screw and nut, and the oracle that it is measured against."""
