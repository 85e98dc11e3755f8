#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rows of Table 1 of Schott et al. 2013 on two scenes, through the mapper: bench_occlusion_table1.py [DATA]

Thin shells of Marschner-Lobb 256^3 with a million triangles of tubes in them; with DATA, a brain cut open with
fibres. 512^2 pixels, 16 directions at half size. The settings take turns, one frame each, the camera one degree on
each time; a frame ends when OpenGL has finished. Prints topic,case,method,parameter,n,threads,min_ns,error,
error_kind: n is the number of triangles, the error a ratio of times, its kind says of which.

"vicinity" is geometry by geometry alone, its light planes included. "geometry-buffer" is the private draw alone;
what geometry adds beyond it is the mapper's own time less that draw, over its time without geometry.
"""
import os
import sys

import numpy as np
from bench_occlusion_vtk import FRAMES, N, THREADS, Run, classification, peer, race
from occlusion_scene import marschner_lobb
from tube_lines import abc_flow, poly_data
from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from chiaroscuro import vtkChiStreamTubes
from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

TRIANGLES = 1_000_000
SIDES = 8


def mapper(strength=1.0, volume=True, vicinity=True):
    """The four interactions by who darkens whom."""
    made = vtkChiCombinedOcclusionVolumeMapper()
    made.SetOcclusionStrength(strength)
    made.SetVolumeToVolume(volume)
    made.SetVolumeToGeometry(volume)
    made.SetGeometryToVolume(volume)
    made.SetVicinityOcclusion(vicinity)
    return made


def tubes_in_shells():
    """Stream lines of the ABC flow within the volume, as tubes of a million triangles; that number."""
    points = 250
    lines = abc_flow(TRIANGLES // (2 * SIDES * points), points)
    lines = [0.85 * np.sin(0.35 * line) for line in lines]
    tubes, drawn, actor = vtkChiStreamTubes(), vtkPolyDataMapper(), vtkActor()
    tubes.SetInputData(poly_data(lines))
    tubes.SplineFittingOff()
    tubes.SetNumberOfSides(SIDES)
    tubes.RadiusIsRelativeOff()
    tubes.SetRadius(0.008)
    tubes.Update()
    drawn.SetInputConnection(tubes.GetOutputPort())
    actor.SetMapper(drawn)
    actor.GetProperty().SetColor(0.9, 0.7, 0.4)
    strips = tubes.GetOutput().GetStrips()
    return actor, strips.GetNumberOfConnectivityIds() - 2 * strips.GetNumberOfCells()


class Shells:
    name = f"ml{N}-shells with tubes"

    def __init__(self):
        self.data = marschner_lobb(N, np.uint8)
        self.actor, self.triangles = tubes_in_shells()

    def run(self, made, geometry=True, shade=False):
        prop = classification("shells")
        prop.SetShade(shade)
        run = Run(self.data, made, prop)
        if geometry:
            run.scene.renderer.AddActor(self.actor)
        return run


class Brain:
    name = "brain with fibres"

    def __init__(self, data):
        sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Python"))
        from brain_with_fibres import scene

        self.source, mapper = scene(data)
        volumes, actors = self.source.GetVolumes(), self.source.GetActors()
        self.volume = volumes.GetItemAsObject(0)
        self.actors = [actors.GetItemAsObject(i) for i in range(actors.GetNumberOfItems())]
        mapper.GetInputAlgorithm().Update()
        self.data = mapper.GetDataSetInput()
        self.triangles = 0
        for actor in self.actors:
            actor.GetMapper().Update()
            strips = actor.GetMapper().GetInput().GetStrips()
            self.triangles += strips.GetNumberOfConnectivityIds() - 2 * strips.GetNumberOfCells()

    def run(self, made, geometry=True, shade=False):
        from vtkmodules.vtkRenderingCore import vtkVolumeProperty

        prop = vtkVolumeProperty()
        prop.DeepCopy(self.volume.GetProperty())
        prop.SetShade(shade)
        run = Run(self.data, made, prop)
        run.scene.renderer.GetVolumes().GetItemAsObject(0).SetPosition(self.volume.GetPosition())
        for actor in self.actors if geometry else []:
            run.scene.renderer.AddActor(actor)
        camera, given = run.camera, self.source.GetActiveCamera()
        camera.SetPosition(given.GetPosition())
        camera.SetFocalPoint(given.GetFocalPoint())
        camera.SetViewUp(given.GetViewUp())
        camera.SetViewAngle(given.GetViewAngle())
        run.start = camera.GetPosition()
        return run


def row(case, method, n, nanoseconds, value, kind):
    print(f"occlusion_table1,{case},{method},16,{n},{THREADS},{nanoseconds:.0f},{value:.4g},{kind}", flush=True)


def measure(scene):
    runs = {
        "chi unshaded": scene.run(mapper(0.0)),
        "chi Phong": scene.run(mapper(0.0), shade=True),
        "chi vicinity": scene.run(mapper(volume=False)),
        "chi volumetric": scene.run(mapper(vicinity=False)),
        "chi combined": scene.run(mapper()),
        "chi unshaded (volume alone)": scene.run(mapper(0.0), geometry=False),
        "chi volumetric (volume alone)": scene.run(mapper(vicinity=False), geometry=False),
        "vtkGPUVolumeRayCastMapper (volume alone)": scene.run(peer(min(scene.data.GetSpacing())), geometry=False),
    }
    times = dict(zip(runs, race(list(runs.values()), FRAMES)))
    for name, nanoseconds in times.items():
        row(scene.name, name, scene.triangles, nanoseconds, nanoseconds / times["chi volumetric"], "time_over_volumetric")
    # the mapper's own time: the renderer draws the geometry itself in both
    combined, alone = runs["chi combined"], runs["chi volumetric (volume alone)"]
    draw, rest, without = [], [], []
    for _ in range(FRAMES):
        combined.next_frame()
        alone.next_frame()
        draw.append(combined.mapper.GetSecondsGeometry())
        rest.append(combined.mapper.GetSecondsTotal() - combined.mapper.GetSecondsGeometry())
        without.append(alone.mapper.GetSecondsTotal())
    row(scene.name, "geometry-buffer", scene.triangles, 1e9 * min(draw), 1e9 * min(draw) / times["chi volumetric"],
        "time_over_volumetric")
    row(scene.name, "chi combined (beyond its draw)", scene.triangles, 1e9 * min(rest), min(rest) / min(without),
        "time_over_volume_alone")


def main():
    vtkSMPTools.SetBackend("STDThread")
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    measure(Shells())
    if len(sys.argv) > 1:
        measure(Brain(sys.argv[1]))


if __name__ == "__main__":
    main()
