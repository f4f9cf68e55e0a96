"""`surae protocol`."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from surae import api
from surae.base.errors import InputError
from surae.base.files import shown
from surae.base.formatting import listed
from surae.base.names import DESIGNED, DEVICES, PROFILES, TELLING
from surae.base.requests import MotionSettings
from surae.base.setting import settings_of
from surae.cli.options import NUMBER, PICTURE, completing, flag_of, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_files, show_line

Command = Callable[..., Any]


def device_options(function: Command) -> Command:
    """Add --device and --without-limits, which `device_of` reads."""
    device = click.option(
        "--device",
        default="achilles",
        show_default=True,
        metavar="NAME|FILE.toml|none",
        shell_complete=completing(*DEVICES, "none"),
        help=f"Whose limits hold: {', '.join(DEVICES)}, or yours.",
    )
    reason = click.option(
        "--without-limits", metavar="REASON", help="Why a protocol may be written for no device."
    )
    return device(reason(function))


@click.command(
    "protocol",
    help=f"""Make a measurement protocol: the motion and the effort to ask for.

    NAME is {listed(PROFILES, "or")};
    or one that was designed: {listed(DESIGNED, "or")};
    or small random perturbations or stretches, which tell tissue from nerve:
    {listed((*TELLING,), "or")}.
    The file holds time_s, angle_rad and the target effort 0…1 of the four muscles,
    emg_ta … emg_gm.
    """,
)
@click.argument("name", metavar="NAME", shell_complete=completing(*PROFILES, *DESIGNED))
@settings_options(MotionSettings)
@click.option(
    "--chirp-factor",
    type=NUMBER,
    metavar="S",
    help="Instead of --chirp-rate, the thesis's s of A·sin(s·t²): S/π Hz/s.",
)
@device_options
@click.option("--output", required=True, metavar="P.csv|P.mat", help="Where the protocol goes.")
@click.option("--figure", type=PICTURE, metavar="P.svg|pdf|png", help="Draw it.")
def command(
    name: str,
    chirp_factor: float | None,
    device: str,
    without_limits: str | None,
    output: str,
    figure: str | None,
    options: dict[str, Any],
) -> None:
    """Make a measurement protocol."""
    shaping = sorted(
        f"--{flag_of(each, record)}"
        for each, record in settings_of(MotionSettings)
        if each.name in options and each.name not in ("angle_range", "rate_hz")
    )
    shaping += ["--chirp-factor"] * (chirp_factor is not None)
    if chirp_factor is not None:
        if "chirp_rate" in options:
            raise InputError("--chirp-rate and --chirp-factor say the same; give one of them")
        options["chirp_rate"] = api.chirp_rate(chirp_factor)
    limiting = device_of(device, without_limits)
    no_adapt = "adapt" in options
    if no_adapt and limiting is None:
        raise InputError("--no-adapt has no effect without the limits of a device")
    file_kind("--output", output, ".csv", ".mat")
    check_outputs({"--output": output, "--figure": figure}, [])

    limits = api.as_device(limiting)
    options["angle_range"] = api.allowed_range(limits, options.get("angle_range"))
    if name in api.ready_protocols() or name in TELLING:
        if shaping:
            raise InputError(
                f"{shaping[0]}: {name} was designed as a whole; leave {', '.join(shaping)} out, or "
                "design your own: surae design"
            )
        how = limits, options["angle_range"], options.get("rate_hz", MotionSettings().rate_hz)
        if name in TELLING:
            trajectory = api.telling(name, *how)
            table = api.telling_words(trajectory)
        else:
            with compilation_notice():
                trajectory = api.ready_trajectory(name, *how)
            table = [f"{name}: {api.ready_protocols()[name].description}"]
    else:
        settings = api.Protocol(profile=name, device=limits, **options)
        trajectory = api.generate(settings)
        given_up: tuple[str, ...] = ()
        if limits is not None and not no_adapt:
            with compilation_notice():
                trajectory, given_up = api.held_to_torque(settings)
        table = _table(settings, trajectory, given_up)
    with compilation_notice():
        limits_checked = api.requested_limits(trajectory)
    beyond = "; ".join(limit.message for limit in limits_checked if limit.exceeded)
    if beyond:
        raise InputError(
            f"{name}: {beyond}; leave --no-adapt out, which gives up effort and range as far as "
            "needed"
        )
    api.write_protocol(trajectory, output, without_limits=without_limits)
    if figure is not None:
        api.write_figure(figure, api.protocol_figure(trajectory))
    for line in (*table, *(limit.message for limit in limits_checked)):
        show_line(line)
    show_files({"protocol": output, "figure": figure})


def device_of(name: str, without_limits: str | None) -> str | None:
    """The device to ask for; None where a reason says why no limits need be kept.

    Neither a device nor a reason, or both, is an InputError.
    """
    reason = (without_limits or "").strip()
    if name.lower() == "none" and not reason:
        raise InputError(
            "--device none: nothing is written without the limits of a device; name it, or say why "
            "with --without-limits REASON"
        )
    if name.lower() != "none" and without_limits is not None:
        raise InputError(f"--without-limits: the limits of {name} are kept; leave it out")
    return None if name.lower() == "none" else name


def file_kind(option: str, path: str, *allowed: str) -> str:
    """The kind of file that a path's ending names."""
    suffix = Path(path).suffix.lower()
    if suffix not in allowed:
        raise InputError(
            f"{option}: {shown(path)} must end in {' or '.join(allowed)}, which says what to write"
        )
    return suffix


def _table(
    settings: "api.Protocol", trajectory: "api.Trajectory", given_up: tuple[str, ...]
) -> list[str]:
    """What the protocol asks for, in a few lines."""
    adaptation = trajectory.adaptation
    low, high = settings.angle_range
    least = float(trajectory.angle.min())
    most = float(trajectory.angle.max())
    velocity, acceleration = api.peaks(
        (trajectory.angle, trajectory.velocity, trajectory.acceleration)
    )
    if adaptation is not None:
        velocity = adaptation.peak_velocity[1]
        acceleration = adaptation.peak_acceleration[1]
    amplitude = settings.chirp_amplitude if adaptation is None else adaptation.chirp_amplitude[1]
    chirp = f"{amplitude:.3g} rad, 0 to {settings.chirp_rate * settings.seconds:.3g} Hz"
    rows = {
        "motion": api.PROFILES[settings.profile].description,
        "effort": settings.effort_task.description,
        "duration": f"{settings.seconds:g} s, {len(trajectory.time)} samples at "
        f"{settings.rate_hz:g} Hz",
        "span": f"{least:.3f} to {most:.3f} rad, {100 * (most - least) / (high - low):.3g} % of "
        "the range of motion",
        "chirp": chirp if amplitude > 0.0 else "none",
        "peak velocity": f"{velocity:.3g} rad/s",
        "peak acceleration": f"{acceleration:.3g} rad/s²",
    }
    if adaptation is not None:
        steps = (*adaptation.steps, *given_up) or ("nothing: the device follows it as it is.",)
        rows["adapted"] = steps[0]
        rows |= {" " * (k + 1): step for k, step in enumerate(steps[1:])}
    width = max(len(name) for name in rows)
    title = f"{settings.profile}, {settings.task}"
    return [title, "", *(f"{name.strip():<{width}}  {value}" for name, value in rows.items()), ""]
