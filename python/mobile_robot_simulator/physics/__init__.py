"""What moves: robots under velocity commands, obstacles, contact between them, and odometry."""
