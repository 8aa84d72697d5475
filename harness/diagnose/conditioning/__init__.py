"""Recordings before anything is fitted: units, zeros, held starts, free motion."""
