"""Controllers as data, and their design: synthesis, margins, schedules, adaptation, export."""
