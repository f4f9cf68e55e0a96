"""`surae simulate`."""

from typing import Any

import click

from surae import api
from surae.base import names
from surae.base.errors import ComputationError, InputError, within
from surae.base.files import shown
from surae.base.formatting import listed
from surae.cli.options import OneOf, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_line


@click.command("simulate")
@click.argument("recording", metavar="IN.csv")
@click.option(
    "--model",
    type=OneOf(names.MODELS),
    metavar="M",
    help=f"{listed(names.MODELS, 'or')}.  [default: that of FIT.json, else muscle]",
)
@click.option(
    "--parameters",
    required=True,
    metavar="P.json",
    help='{"parameters": {"m": 2.0, …}} or a FIT.json.',
)
@click.option("--output", required=True, metavar="OUT.csv", help="Where the torque goes.")
@settings_options(api.ModelOptions)
def command(
    recording: str, model: str | None, parameters: str, output: str, options: dict[str, Any]
) -> None:
    """Compute the torque that a model gives for the angle and EMG of a recording.

    IN.csv is a recording, or a protocol as surae protocol writes it, whose efforts are EMG in parts
    of the largest. The signals are used as they are; of raw EMG the envelopes, made and sampled as
    surae fit does. OUT.csv holds them with torque_Nm, the modelled torque, and
    its parts; muscle-tendon models add lengths, velocities and forces of muscles and tendons.
    P.json may hold emd, a delay of the EMG, and reflex_tri, reflex_tib, reflex_delay, a reflex. A
    FIT.json also says the model and its options, unless they are given here.
    """
    measured = api.to_read(recording)
    assert isinstance(measured, api.Recording)  # a file holds no other
    inputs = api.to_simulate(measured)
    check_outputs(
        {"--output": output},
        [parameters, recording, *(file.path for file in measured.files)],
    )

    source = api.read_parameters(parameters)
    spec = api.with_optional(api.get_model(model or source.model or "muscle"), source.values)
    settings = dict(source.options) | options
    known = api.ModelOptions.of(**settings)
    with within(shown(parameters)):
        values = spec.vector(source.values, known)
    if source.emg_unit not in (None, inputs.emg_unit):
        raise InputError(
            f"{shown(recording)}: its EMG is in {inputs.emg_unit!r}, that of {shown(parameters)} "
            f"in {source.emg_unit!r}; the weights do not carry over: of parts of the largest EMG, "
            "as a protocol asks for them, give a fit made with --normalise session"
        )
    weights = dict(zip(api.MUSCLES, spec.weights, strict=True))
    silent = [muscle for muscle in inputs.missing_emg if source.values[weights[muscle]]]
    if silent:
        click.echo(
            f"surae: {shown(recording)}: no EMG of {', '.join(silent)}; taken as silent", err=True
        )
    with compilation_notice():
        try:
            parts = api.simulate_parts(spec.name, source.values, inputs, **settings)
        except ComputationError as error:
            raise ComputationError(f"{shown(parameters)}: {error}") from None
        state = spec.simulator(inputs, known).tendon(values)
    if not inputs.prepared:
        said = f"its EMG is raw: envelopes are used, at {inputs.rate_hz:g} Hz as surae fit has them"
        click.echo(f"surae: {shown(recording)}: {said}", err=True)
    signals = api.csv_columns(measured) if inputs.prepared else inputs.columns()
    table = signals | {"torque_Nm": parts.total} | dict(parts.columns())
    if state is not None:
        table |= state.columns()
    # The model takes the EMG as an envelope, whatever the file said of it.
    api.write_csv(output, table, ["emg: envelope", f"torque simulated with model {spec.name}"])
    show_line(f"simulated: {shown(output)}")
