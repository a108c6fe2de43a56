// One of too many.
