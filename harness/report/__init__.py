"""Tables, HTML, plots, JUnit XML."""
