"""How a run that cannot go on ends."""


class RunFailed(Exception):  # noqa: N818 - a failed run is a result, not an error
    """The run cannot go on. `particle`: its row in the initial layout, -1 if none; `cell`: where it is."""

    def __init__(self, reason: str, step: int = 0, particle: int = -1, cell: tuple[int, int] | None = None) -> None:
        super().__init__(reason)
        self.reason, self.step, self.particle, self.cell = reason, step, particle, cell
