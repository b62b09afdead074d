"""Draws a run with VTK, without a display.

    python -m pip install vtk numpy
    python scripts/picture.py RUN OUT.png [--field speed] [--frame -1] [--size 1400x1050]

Spheres have their true sizes; colours show a field of the particles (the size of a vector, or `height`). Walls are
drawn as outlines, the floor as a surface.
"""

import argparse

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

# viridis, which is even in brightness and reads in grey
COLOURS = ((0.267, 0.005, 0.329), (0.254, 0.265, 0.530), (0.164, 0.471, 0.558), (0.135, 0.659, 0.518), (0.478, 0.821, 0.318), (0.993, 0.906, 0.144))
INK = (0.15, 0.17, 0.20)


def read(path, frame):
    """A master at one of its times."""
    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    reader.UpdateTimeStep(times[frame])
    data = vtk.vtkPolyData()
    data.DeepCopy(reader.GetOutputDataObject(0))
    return data, times[frame]


def values_of(particles, field):
    if field == "height":
        return vtk_to_numpy(particles.GetPoints().GetData())[:, 2].copy(), "height, m"
    units = {"velocity": "speed, m/s", "speed": "speed, m/s", "displacement": "displacement, m", "force": "force, N"}
    array = particles.GetPointData().GetArray("velocity" if field == "speed" else field)
    if array is None:
        names = [particles.GetPointData().GetArrayName(k) for k in range(particles.GetPointData().GetNumberOfArrays())]
        raise SystemExit(f"no field {field!r}; there are: height, speed, {', '.join(sorted(names))}")
    values = vtk_to_numpy(array).astype(float)
    return (np.linalg.norm(values, axis=1) if values.ndim > 1 else values), units.get(field, field.replace("_", " "))


def colours(low, high):
    table = vtk.vtkColorTransferFunction()
    for share, colour in zip(np.linspace(0, 1, len(COLOURS)), COLOURS):
        table.AddRGBPoint(low + share * (high - low), *colour)
    return table


def spheres(particles, values, table):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
    array.SetName("shown")
    particles.GetPointData().AddArray(array)
    few = particles.GetNumberOfPoints() < 50_000
    source = vtk.vtkSphereSource()
    source.SetRadius(1.0)
    source.SetThetaResolution(32 if few else 14)
    source.SetPhiResolution(20 if few else 10)
    mapper = vtk.vtkGlyph3DMapper()
    mapper.SetInputData(particles)
    mapper.SetSourceConnection(source.GetOutputPort())
    mapper.SetScaleArray("radius")
    mapper.SetScaleModeToScaleByMagnitude()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("shown")
    mapper.SetLookupTable(table)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.15)
    actor.GetProperty().SetSpecular(0.25)
    actor.GetProperty().SetSpecularPower(30)
    return actor


def outlines(walls):
    edges = vtk.vtkExtractEdges()
    edges.SetInputData(walls)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(edges.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.45, 0.48, 0.53)
    actor.GetProperty().SetLineWidth(1.5)
    return actor


def floor(walls):
    """The lowest wall that is level, as a surface."""
    points = vtk_to_numpy(walls.GetPoints().GetData())
    best = None
    for index in range(walls.GetNumberOfCells()):
        ids = walls.GetCell(index).GetPointIds()
        corners = points[[ids.GetId(k) for k in range(ids.GetNumberOfIds())]]
        if np.ptp(corners[:, 2]) < 1e-6 * np.ptp(corners) and (best is None or corners[0, 2] < best[0, 2]):
            best = corners
    if best is None:
        return None
    data, cells, corners = vtk.vtkPolyData(), vtk.vtkCellArray(), vtk.vtkPoints()
    cells.InsertNextCell(len(best))
    for corner in best:
        cells.InsertCellPoint(corners.InsertNextPoint(*map(float, corner)))
    data.SetPoints(corners)
    data.SetPolys(cells)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.90, 0.91, 0.93)
    actor.GetProperty().LightingOff()
    return actor


def scale_bar(table, title):
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetTitle(title)
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("{:.3g}" if vtk.vtkVersion().GetVTKMajorVersion() * 100 + vtk.vtkVersion().GetVTKMinorVersion() >= 906 else "%.3g")
    bar.UnconstrainedFontSizeOn()
    bar.SetBarRatio(0.25)
    bar.SetVerticalTitleSeparation(14)
    bar.SetPosition(0.9, 0.25)
    bar.SetWidth(0.09)
    bar.SetHeight(0.5)
    for text, size in ((bar.GetTitleTextProperty(), 20), (bar.GetLabelTextProperty(), 18)):
        text.SetColor(*INK)
        text.SetFontSize(size)
        text.BoldOff()
        text.ItalicOff()
        text.ShadowOff()
    return bar


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run")
    parser.add_argument("out")
    parser.add_argument("--field", default="speed", help="speed, height, or any field of the particles")
    parser.add_argument("--frame", type=int, default=-1, help="number of the frame, from the end if negative")
    parser.add_argument("--size", default="1400x1050")
    parser.add_argument("--direction", default="1,-1.8,0.75", help="where the camera stands, seen from the particles")
    arguments = parser.parse_args()
    width, height = (int(part) for part in arguments.size.split("x"))

    particles, time = read(f"{arguments.run}/particles.vtkhdf", arguments.frame)
    walls, _ = read(f"{arguments.run}/walls.vtkhdf", arguments.frame)
    values, title = values_of(particles, arguments.field)
    low, high = float(values.min()), float(values.max())
    table = colours(low, high if high > low else low + 1.0)

    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(spheres(particles, values, table))
    if walls.GetNumberOfCells():
        renderer.AddActor(outlines(walls))
        ground = floor(walls)
        if ground is not None:
            renderer.AddActor(ground)
    renderer.AddViewProp(scale_bar(table, title))
    text = vtk.vtkTextActor()
    text.SetInput(f"{particles.GetNumberOfPoints():,} spheres, t = {time:.3g} s")
    text.GetTextProperty().SetColor(*INK)
    text.GetTextProperty().SetFontSize(22)
    text.SetPosition(24, 20)
    renderer.AddViewProp(text)

    occlusion = vtk.vtkSSAOPass()
    size = np.ptp(vtk_to_numpy(particles.GetPoints().GetData()), axis=0).max()
    occlusion.SetRadius(0.08 * size)
    occlusion.SetBias(0.002 * size)
    occlusion.SetKernelSize(128)
    occlusion.BlurOn()
    steps = vtk.vtkRenderStepsPass()
    occlusion.SetDelegatePass(steps)
    smooth = vtk.vtkSSAAPass()
    smooth.SetDelegatePass(occlusion)
    renderer.SetPass(smooth)

    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    centre = np.array(particles.GetCenter())
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(centre + np.array([float(part) for part in arguments.direction.split(",")])))
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(25)
    renderer.ResetCamera(particles.GetBounds())
    camera.Zoom(1.0)
    camera.SetWindowCenter(0.1, 0.0)  # room for the scale on the right
    renderer.ResetCameraClippingRange()
    window.Render()

    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(arguments.out)
    writer.Write()


if __name__ == "__main__":
    main()
