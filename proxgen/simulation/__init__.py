"""Simulated arms in scenes: sensors, plants, the closed loop; pybullet is loaded where it is first needed."""
