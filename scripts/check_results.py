"""Reads a run with VTK and h5py, and checks that both see what was computed.

    python -m pip install vtk h5py numpy
    python scripts/check_results.py RUN [RUN ...]

Every instant of every master, of every packed file and every single frame is read. Exit code 1 and a line per
finding if anything is wrong.
"""

import csv
import shutil
import sys
import tempfile
import tomllib
from pathlib import Path

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

SINGLE = 1e-5  # relative: numbers in frames have 24 bits, and sums of many of them a little less


class Findings:
    def __init__(self):
        self.count = 0
        self.checks = 0

    def check(self, holds, text):
        self.checks += 1
        if not holds:
            self.count += 1
            print(f"WRONG: {text}")

    def close(self, found, expected, scale, text):
        self.check(abs(found - expected) <= SINGLE * max(abs(scale), 1e-30), f"{text}: {found} instead of {expected}")


def read_history(path):
    with open(path, newline="") as file:
        return {int(row["step"]): {name: float(value) for name, value in row.items()} for row in csv.DictReader(file)}


def read_frame(path):
    """Arrays of a frame by block, as h5py sees them."""
    with h5py.File(path) as file:
        frame = {"step": int(file["tdem/step"][0]), "time": float(file["tdem/time"][0]), "blocks": {}, "path": path}
        about = file["VTKHDF/particles/FieldData"]
        frame["about"] = {name: about[name][...].tolist() for name in about}
        for name in file["tdem/fixed"]:
            group = file["VTKHDF"][name]
            frame["blocks"][name] = {
                "points": group["Points"][...],
                "connectivity": {kind: group[kind]["Connectivity"][...] for kind in ("Vertices", "Lines", "Polygons")},
                "point": {field: data[...] for field, data in group["PointData"].items()},
                "cell": {field: data[...] for field, data in group["CellData"].items()},
                "units": {field: data.attrs.get("unit") for kind in ("PointData", "CellData") for field, data in group[kind].items()},
            }
        return frame


def check_labels(findings, frame):
    for name, block in frame["blocks"].items():
        for field, unit in block["units"].items():
            findings.check(unit is not None, f"{frame['path']}: {name}/{field} has no unit")
        rows = {"point": len(block["points"]), "cell": None}
        for place, fields in (("point", block["point"]), ("cell", block["cell"])):
            lengths = {len(values) for values in fields.values()}
            expected = rows[place]
            findings.check(len(lengths) <= 1, f"{frame['path']}: {name} has {place} fields of lengths {lengths}")
            if expected is not None and lengths:
                findings.check(lengths == {expected}, f"{frame['path']}: {name} has {lengths} values for {expected} points")


def same_arrays(findings, where, data, fields):
    """VTK's arrays against those of the frame, bit by bit."""
    names = {data.GetArrayName(index) for index in range(data.GetNumberOfArrays())}
    findings.check(names == set(fields), f"{where}: arrays {sorted(names)} instead of {sorted(fields)}")
    for name in names & set(fields):
        array = data.GetArray(name)
        if array.GetNumberOfTuples() == 0:
            findings.check(len(fields[name]) == 0, f"{where}: {name} is empty")
            continue
        found = vtk_to_numpy(array)
        findings.check(np.array_equal(found, fields[name], equal_nan=True), f"{where}: {name} differs")


def same_block(findings, where, data, block):
    points = vtk_to_numpy(data.GetPoints().GetData()) if data.GetNumberOfPoints() else np.empty((0, 3))
    findings.check(np.array_equal(points, block["points"]), f"{where}: points differ")
    for kind, cells in (("Vertices", data.GetVerts()), ("Lines", data.GetLines()), ("Polygons", data.GetPolys())):
        found = vtk_to_numpy(cells.GetConnectivityArray()) if cells.GetNumberOfCells() else np.empty(0, int)
        findings.check(np.array_equal(found, block["connectivity"][kind]), f"{where}: {kind} differ")
    same_arrays(findings, where, data.GetPointData(), block["point"])
    same_arrays(findings, where, data.GetCellData(), block["cell"])


def same_field_data(findings, where, data, about):
    """Step, time of the heat, title, and names of materials, as VTK sees them."""
    fields = data.GetFieldData()
    for name, expected in about.items():
        array = fields.GetAbstractArray(name)
        findings.check(array is not None, f"{where}: there is no field data {name}")
        if array is not None:
            found = [array.GetValue(index) for index in range(array.GetNumberOfValues())]
            expected = [value.decode() if isinstance(value, bytes) else value for value in expected]
            findings.check(found == expected, f"{where}: {name} is {found} instead of {expected}")


def check_single_frame(findings, frame):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(frame["path"]))
    reader.Update()
    collection = reader.GetOutputDataObject(0)
    findings.check(collection.IsA("vtkPartitionedDataSetCollection"), f"{frame['path']}: a {collection.GetClassName()}")
    for index in range(collection.GetNumberOfPartitionedDataSets()):
        name = collection.GetMetaData(index).Get(vtk.vtkCompositeDataSet.NAME())
        data = collection.GetPartitionedDataSet(index).GetPartition(0)
        findings.check(name in frame["blocks"], f"{frame['path']}: unknown block {name}")
        if name in frame["blocks"]:
            same_block(findings, f"{frame['path']} {name}", data, frame["blocks"][name])


def check_series(findings, path, frames):
    """A master or a packed file, at every time, forwards and then at random."""
    name = path.stem
    instants = [frame for frame in frames if name in frame["blocks"]]
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()
    findings.check(list(times) == [frame["time"] for frame in instants], f"{path}: times are {times}")
    order = list(range(len(instants)))
    order += list(np.random.default_rng(1).permutation(len(instants))[:10])
    for index in order:
        frame = instants[index]
        reader.UpdateTimeStep(frame["time"])
        same_block(findings, f"{path} at {frame['time']} s", reader.GetOutputDataObject(0), frame["blocks"][name])
        same_field_data(findings, f"{path} at {frame['time']} s", reader.GetOutputDataObject(0), frame["about"])
    with h5py.File(path) as file:
        for place in ("point", "cell"):
            for field, data in file["VTKHDF"][f"{place.title()}Data"].items():
                expected = np.concatenate([frame["blocks"][name][place][field] for frame in instants])
                findings.check(np.array_equal(data[...], expected, equal_nan=True), f"{path}: h5py reads another {field}")
                findings.check("unit" in data.attrs, f"{path}: {field} has no unit")


def check_copy(findings, path):
    """A master copied without its frames: it holds all numbers, or says that it is an index and shows none."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copy(path, folder))
        with h5py.File(path) as file, h5py.File(copy) as alone:
            index = "index" in file.attrs["content"].decode()
            for place in ("Points", "PointData", "CellData"):
                group = file["VTKHDF"][place]
                names = [place] if place == "Points" else [f"{place}/{name}" for name in group]
                for name in names:
                    here, there = alone["VTKHDF"][name][...], file["VTKHDF"][name][...]
                    if index:
                        nothing = np.isnan(here) if here.dtype.kind == "f" else here == -1
                        findings.check(bool(nothing.all()), f"{path}: a copy without frames shows numbers in {name}")
                    else:
                        findings.check(np.array_equal(here, there, equal_nan=True), f"{path}: a copy has another {name}")
        reader = vtk.vtkHDFReader()
        reader.SetFileName(str(copy))
        reader.Update()
        data = reader.GetOutputDataObject(0)
        if index:
            findings.check(data.GetNumberOfPoints() == 0, f"{path}: a copy without frames shows points")
        elif path.stem == "particles":
            findings.check(data.GetNumberOfPoints() > 0, f"{path}: a copy shows no points")


def check_physics(findings, frame, row):
    """Numbers of a frame against the row of the history of the same step."""
    where = f"step {frame['step']}"
    particles = frame["blocks"]["particles"]["point"]
    mass, velocity = particles["mass"].astype(float), particles["velocity"].astype(float)
    kinetic = 0.5 * float(np.sum(mass * np.sum(velocity**2, axis=1)))
    findings.close(kinetic, row["kinetic_translation"], row["kinetic_translation"], f"{where}: kinetic energy")
    findings.close(np.sqrt(np.sum(velocity**2, axis=1)).max(), row["largest_speed"], row["largest_speed"], f"{where}: speed")
    findings.close(frame["time"], row["time"], 1.0, f"{where}: time")
    findings.check(particles["coordination_number"].sum() == 2 * row["contacts"], f"{where}: coordination numbers")
    walls = frame["blocks"]["walls"]["cell"]
    findings.check(walls["touching"].sum() == row["wall_contacts"], f"{where}: wall contacts")
    total = walls["force"].astype(float).sum(axis=0) if len(walls["force"]) else np.zeros(3)
    scale = np.abs(walls["force"]).sum() if len(walls["force"]) else 1.0
    for axis, name in enumerate("xyz"):
        findings.close(total[axis], row[f"wall_force_{name}"], scale, f"{where}: force on walls along {name}")

    if "contacts" in frame["blocks"]:
        contacts = frame["blocks"]["contacts"]
        count = row["contacts"] + row["wall_contacts"]
        findings.check(len(contacts["points"]) == 2 * count, f"{where}: number of contacts")
        # A line that crossed the box instead of its seam would be far longer than two radii.
        ends = contacts["points"].astype(float).reshape(-1, 2, 3)
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        radius = dict(zip(particles["id"], particles["radius"].astype(float)))
        first, second = contacts["cell"]["first"], contacts["cell"]["second"]
        reach = np.array([radius[a] + (radius[b] if b >= 0 else 0.0) for a, b in zip(first, second)])
        wrong = np.abs(length + contacts["cell"]["overlap"] - reach) > 1e-4 * np.maximum(reach, 1e-30)
        findings.check(not wrong.any(), f"{where}: {wrong.sum()} contact lines are not as long as their spheres ask")


def check_heat(findings, frame, row):
    """Temperatures against the row of the history of the same step."""
    where = f"step {frame['step']}"
    temperature = frame["blocks"]["particles"]["point"]["temperature"].astype(float)
    scale = row["highest_temperature"]
    for found, name in [(temperature.min(), "lowest"), (temperature.mean(), "mean"), (temperature.max(), "highest")]:
        findings.close(found, row[f"{name}_temperature"], scale, f"{where}: {name} temperature")
    moved = abs(row["heat_in"]) + abs(row["heat_out"]) + abs(row["heat_made"])
    findings.check(abs(row["heat_error"]) <= 1e-9 * moved + 1e-12, f"{where}: {row['heat_error']} J of heat are unexplained")


def check_bonds(findings, frame, row):
    """Bonds, cracks and what they say of particles, against each other and the row of the history of the same step."""
    where = f"step {frame['step']}"
    particles, cracks = frame["blocks"]["particles"], frame["blocks"]["cracks"]
    field, broken = particles["point"], cracks["point"]
    findings.check(field["bonds"].sum() == 2 * row["bonds"], f"{where}: bonds of particles")
    findings.check(len(cracks["points"]) == row["broken_bonds"], f"{where}: number of cracks")
    energy = broken["energy"].astype(float)
    findings.close(energy.sum(), row["breakage_dissipated"], np.abs(energy).sum(), f"{where}: energy of cracks")
    findings.check(bool(np.all(broken["breakage_step"] <= frame["step"])), f"{where}: cracks of the future")
    findings.check(bool(np.all(broken["breakage_time"] <= frame["time"] * (1 + SINGLE))), f"{where}: times of cracks")
    length = np.linalg.norm(broken["normal"].astype(float), axis=1)
    findings.check(bool(np.all(np.abs(length - 1) < SINGLE)), f"{where}: normals of cracks")
    if "bonds" not in frame["blocks"]:
        return

    bonds = frame["blocks"]["bonds"]
    cell, ends = bonds["cell"], bonds["points"].astype(float).reshape(-1, 2, 3)
    holds = cell["holds"] == 1
    findings.check(len(ends) == row["bonds"] + row["broken_bonds"], f"{where}: number of bonds")
    findings.check(holds.sum() == row["bonds"], f"{where}: bonds that hold")
    findings.check(bool(np.all(holds == (cell["failure"] == 0))), f"{where}: failure of bonds that hold")
    findings.check(bool(np.all(holds == np.isnan(cell["breakage_time"]))), f"{where}: time of bonds that hold")
    findings.check(not np.any(cell["force"][~holds]), f"{where}: forces of broken bonds")
    findings.check(np.array_equal(cell["first"][~holds], broken["first"]), f"{where}: cracks and broken bonds")
    place = {name: index for index, name in enumerate(field["id"])}
    counts = np.zeros((2, len(place)))
    for first, second, whole in zip(cell["first"], cell["second"], holds):
        for name in (first, second):
            counts[:, place[name]] += (whole, 1)
    damage = 1 - counts[0] / np.maximum(counts[1], 1)
    damage[counts[1] == 0] = 0
    findings.check(bool(np.allclose(field["damage"], damage, atol=SINGLE)), f"{where}: damage")

    if "contacts" in frame["blocks"]:
        # All particles together have the stress of all pairs. At a wall the arm is half an overlap longer than the line.
        contacts = frame["blocks"]["contacts"]
        lines = contacts["points"].astype(float).reshape(-1, 2, 3)
        ways = lines[:, 1] - lines[:, 0]
        at_wall = contacts["cell"]["wall"] >= 0
        size = np.maximum(np.linalg.norm(ways, axis=1), 1e-30)
        ways[at_wall] *= (1 + 0.5 * contacts["cell"]["overlap"] / size)[at_wall, None]
        ways = np.concatenate([ways, ends[:, 1] - ends[:, 0]])
        forces = np.concatenate([contacts["cell"]["force"], cell["force"]]).astype(float)
        products = np.einsum("ki,kj->kij", ways, forces)
        volume = 4 / 3 * np.pi * field["radius"].astype(float) ** 3
        total = (volume[:, None] * field["stress"].astype(float)).sum(axis=0)
        pairs, scale = products.sum(axis=0), 10 * np.abs(products).sum()
        for index, (a, b) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]):
            findings.close(total[index], 0.5 * (pairs[a, b] + pairs[b, a]), scale, f"{where}: stress {a}{b}")


def check_displacement(findings, frames):
    """Steps of the displacement are those of the position, but for whole boxes where the domain repeats."""
    first = frames[0]["blocks"]["particles"]
    findings.check(not np.any(first["point"]["displacement"]), "displacements do not begin at zero")
    for before, after in zip(frames, frames[1:]):
        before, after = before["blocks"]["particles"], after["blocks"]["particles"]
        moved = after["points"].astype(float) - before["points"].astype(float)
        way = after["point"]["displacement"].astype(float) - before["point"]["displacement"].astype(float)
        jump = np.abs(moved - way)
        # A single particle has no extent: its radius stands in.
        size = max(np.ptp(first["points"], axis=0).max(), first["point"]["radius"].max())
        findings.check(bool(np.all((jump < 1e-5 * size) | (jump > 0.5 * size))), "displacements and positions disagree")


def check_gauges(findings, run, history):
    """Gauges of the case have their columns, which begin at zero and belong together; curves are drawn."""
    case = tomllib.loads((run / "case.toml").read_text())
    rows = list(history.values())
    for gauge in case.get("gauge", []):
        name, between = gauge["name"], "between" in gauge
        columns = [f"{name}_{what}" for what in ("elongation", "strain")]
        surface = "surface" in gauge
        if surface:
            columns = [f"{name}_temperature", f"{name}_heat_rate"]
        elif not between:
            columns = [f"{name}_{what}_{axis}" for what in ("displacement", "force") for axis in "xyz"]
        there = all(column in row for row in rows for column in columns)
        findings.check(there, f"{run}: gauge {name} lacks columns")
        if not there:
            continue
        if surface:
            findings.check(all(row[columns[0]] > 0 for row in rows), f"{run}: {name} is below absolute zero")
            continue
        moved = columns[:2] if between else columns[:3]
        if rows[0]["step"] == 0:
            findings.check(all(abs(rows[0][column]) < 1e-15 for column in moved), f"{run}: gauge {name} begins away from zero")
        if between:
            lengths = [row[columns[0]] / row[columns[1]] for row in rows if row[columns[1]] != 0]
            findings.check(np.ptp(lengths or [0]) < 1e-9 * max(lengths or [1]), f"{run}: strain of {name} is not its elongation over one length")
    for curve in case.get("curve", []):
        drawn = run / f"curve-{curve['name']}.svg"
        findings.check(drawn.exists() and "</svg>" in drawn.read_text(), f"{run}: {drawn.name} is not drawn")


def check_run(findings, run):
    frames = [read_frame(path) for path in sorted((run / "frames").glob("*.vtkhdf"))]
    history = read_history(run / "history.csv")
    findings.check(len(frames) > 0, f"{run}: no frames")
    findings.check(list(history) == sorted(history), f"{run}: history is not ascending")
    for frame in frames:
        check_labels(findings, frame)
        check_single_frame(findings, frame)
        if frame["step"] in history:
            check_physics(findings, frame, history[frame["step"]])
            if "heat_time" in history[frame["step"]]:
                check_heat(findings, frame, history[frame["step"]])
            if "cracks" in frame["blocks"]:
                check_bonds(findings, frame, history[frame["step"]])
    check_displacement(findings, frames)
    check_gauges(findings, run, history)
    names = sorted({name for frame in frames for name in frame["blocks"]})
    masters = sorted(run.glob("*.vtkhdf"))
    findings.check([path.stem for path in masters] == names, f"{run}: masters {masters} for blocks {names}")
    for path in masters + sorted((run / "packed").glob("*.vtkhdf")):
        check_series(findings, path, frames)
        check_copy(findings, path)
    rows = sum(frame["step"] in history for frame in frames)
    print(f"{run}: {len(frames)} frames, {len(history)} rows of history, {rows} compared, blocks {', '.join(names)}")


def main():
    runs = [Path(argument) for argument in sys.argv[1:]]
    if not runs:
        sys.exit(__doc__)
    print(f"VTK {vtk.vtkVersion().GetVTKVersion()}, h5py {h5py.__version__}")
    findings = Findings()
    for run in runs:
        check_run(findings, run)
    print(f"{findings.checks} checks, {findings.count} wrong")
    sys.exit(1 if findings.count or not findings.checks else 0)


if __name__ == "__main__":
    main()
