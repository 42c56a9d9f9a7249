"""The study of contact geometry: what it plans (``study``), its measures, and the truth they compare with."""
