"""Tables of an OpenSim model's leg over the ankle's and the knee's angle, for ``--geometry``.

OpenSim's MuscleAnalysis and Kinematics of a motion through every pair of both angles. Run it as

    .venv/bin/python benchmarks/opensim_tables.py MODEL.osim FOLDER MUSCLE…

with the model's names of the four muscles (soleus_r gasmed_r gaslat_r tibant_r), and give
FOLDER/leg_MuscleAnalysis_Length.sto to a fit. It needs the package opensim (extra `simulators`).
"""

import sys
from itertools import product
from pathlib import Path

import opensim

ANKLE, KNEE = range(-50, 36, 5), range(0, 121, 5)


def main(model: str, folder: Path, muscles: list[str]) -> None:
    """Write the motion, and analyse it."""
    side = muscles[0][-2:]
    rows = [f"{0.01 * i:.2f}\t{a}\t{k}" for i, (a, k) in enumerate(product(ANKLE, KNEE))]
    head = ["grid", "version=1", f"nRows={len(rows)}", "nColumns=3", "inDegrees=yes", "endheader"]
    columns = f"time\tankle_angle{side}\tknee_angle{side}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "grid.mot").write_text("\n".join([*head, columns, *rows]) + "\n", encoding="utf-8")
    tool = opensim.AnalyzeTool()
    tool.setName("leg")
    tool.setModelFilename(model)
    tool.setCoordinatesFileName(str(folder / "grid.mot"))
    tool.setResultsDir(str(folder))
    tool.setLowpassCutoffFrequency(-1)
    tool.setSolveForEquilibrium(False)
    analysis, kinematics = opensim.MuscleAnalysis(), opensim.Kinematics()
    for each, names in (
        (analysis.setMuscles, muscles),
        (analysis.setCoordinates, [f"ankle_angle{side}"]),
    ):
        array = opensim.ArrayStr()
        for name in names:
            array.append(name)
        each(array)
    for each in (tool, analysis, kinematics):
        set_end = each.setFinalTime if each is tool else each.setEndTime
        set_end(0.01 * (len(rows) - 1))
    for each in (analysis, kinematics):
        tool.getAnalysisSet().cloneAndAppend(each)
    setup = folder / "setup.xml"
    tool.printToXML(str(setup))
    opensim.AnalyzeTool(str(setup)).run()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), sys.argv[3:])
