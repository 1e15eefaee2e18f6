"""The files of `rheolog export` as VTK and meshio read them, compared with each other and with the CSV."""
import contextlib
import csv
import io
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import meshio
import vtk

program = os.path.abspath(sys.argv[1])
problems = []
vtk.vtkObject.GlobalWarningDisplayOff()


def run(*arguments):
    subprocess.run([program, *arguments, '--quiet'], check=True, stdout=subprocess.DEVNULL)


def check(holds, text):
    if not holds:
        problems.append(text)
        print('wrong:', text)


class Errors:
    """VTK reports what it cannot read as an event."""

    def __init__(self, reader):
        self.count = 0
        reader.AddObserver('ErrorEvent', self.add)
        reader.AddObserver('WarningEvent', self.add)

    def add(self, *_):
        self.count += 1


def read(reader, path):
    reader.SetFileName(path)
    errors = Errors(reader)
    reader.Update()
    data = reader.GetOutput()
    check(errors.count == 0 and data.GetNumberOfPoints() > 0, f'{path}: VTK cannot read it')
    return data


def vtp(path):
    return read(vtk.vtkXMLPolyDataReader(), path)


def points(data):
    return [data.GetPoint(i) for i in range(data.GetNumberOfPoints())]


def values(attributes, name):
    array = attributes.GetArray(name)
    check(array is not None, f'there is no array {name}')
    return [array.GetTuple(i) for i in range(array.GetNumberOfTuples())] if array else []


def turned(v):
    return (v[0], -v[2], v[1])


def near(a, b, tolerance):
    return all(abs(x - y) <= tolerance for x, y in zip(a, b))


def volume(data):
    clean, normals, mass = vtk.vtkCleanPolyData(), vtk.vtkTriangleFilter(), vtk.vtkMassProperties()
    clean.SetInputData(data)
    normals.SetInputConnection(clean.GetOutputPort())
    mass.SetInputConnection(normals.GetOutputPort())
    mass.Update()
    return mass.GetVolume()


def open_edges(data):
    clean, edges = vtk.vtkCleanPolyData(), vtk.vtkFeatureEdges()
    clean.SetInputData(data)
    edges.SetInputConnection(clean.GetOutputPort())
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


# ---- Particles


def columns(path):
    """The columns of a CSV: name to numbers; vectors are joined."""
    with open(path, newline='') as file:
        rows = list(csv.reader(file))
    table = {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}
    named = {'position': ('x', 'y', 'z'), 'velocity': ('vx', 'vy', 'vz')}
    for name in list(table):
        if name.endswith('_x'):
            named[name[:-2]] = (name, name[:-1] + 'y', name[:-1] + 'z')
    for name, parts in named.items():
        table[name] = list(zip(*(table.pop(part) for part in parts)))
    return table


def check_particles(name, folder, step, expected):
    """Each column of the CSV is an array of the VTP with the same values."""
    table = columns(f'{folder}/{name}_{step:06}.csv')
    data = vtp(f'{folder}/{name}_{step:06}.vtp')
    check(set(expected) <= set(table), f'{name}: columns {set(expected) - set(table)} are missing')
    arrays = data.GetPointData()
    check(arrays.GetNumberOfArrays() == len(table) - 1, f'{name}: the VTP has other arrays than the CSV')
    for column, numbers in table.items():
        own = points(data) if column == 'position' else values(arrays, column)
        numbers = [n if isinstance(n, tuple) else (n,) for n in numbers]
        check(len(own) == len(numbers) and all(near(a, b, 2e-7 * max(1e-30, *map(abs, b))) for a, b in zip(own, numbers)),
              f'{name}: array {column} differs from the CSV')
    check(arrays.GetVectors() and arrays.GetVectors().GetName() == 'velocity', f'{name}: velocities are no vectors')
    return table, data


def check_collection(folder, name, steps, time):
    files = [item.attrib for item in xml.etree.ElementTree.parse(f'{folder}/{name}.pvd').iter('DataSet')]
    check(len(files) == len(steps), f'{name}.pvd has {len(files)} files')
    for step, item in zip(steps, files):
        data = vtp(f"{folder}/{item['file']}")
        at = data.GetFieldData().GetArray('TimeValue').GetValue(0)
        check(abs(float(item['timestep']) - step * time) < 1e-12 and at == float(item['timestep']),
              f"{name}.pvd: {item['file']} is not at the time of step {step}")


# ---- Springs and solids


def check_springs(path, table):
    data = vtp(path)
    cells = data.GetCellData()
    length, rest = values(cells, 'length'), values(cells, 'rest_length')
    stretch, stiffness = values(cells, 'stretch'), values(cells, 'stiffness')
    largest = [0.] * data.GetNumberOfPoints()
    check(data.GetNumberOfLines() == data.GetNumberOfCells() > 1000, f'{path}: not all cells are lines')
    for i in range(data.GetNumberOfCells()):
        ends = [data.GetCell(i).GetPointId(k) for k in range(2)]
        far = math.dist(*(data.GetPoint(end) for end in ends))
        if abs(far - length[i][0]) > 1e-5 * far or abs(length[i][0] - rest[i][0] - stretch[i][0]) > 1e-5 * far:
            check(False, f'{path}: line {i} is not as long as it says')
            break
        for end in ends:
            largest[end] = max(largest[end], stiffness[i][0])
    check(near(largest, table['stiffness'], 1e-4 * max(largest)), f'{path}: particles have other stiffnesses')


def check_solids(path, z_up, radius):
    data = vtp(path)
    cells = data.GetCellData()
    kinds = [int(k[0]) for k in values(cells, 'kind')]
    check(kinds.count(0) >= 1 and kinds.count(1) == 8 * 144, f'{path}: it has no wall or no ball')
    ball = vtk.vtkThreshold()
    ball.SetInputData(data)
    ball.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_CELLS, 'kind')
    ball.SetLowerThreshold(1)
    ball.SetUpperThreshold(1)
    surface = vtk.vtkGeometryFilter()
    surface.SetInputConnection(ball.GetOutputPort())
    surface.Update()
    sphere = surface.GetOutput()
    check(open_edges(sphere) == 0, f'{path}: the ball is open')
    check(.98 < volume(sphere) / (4 / 3 * math.pi * radius ** 3) < 1, f'{path}: the ball has another volume')
    bounds = sphere.GetBounds()
    velocity = values(cells, 'velocity')[kinds.index(1)]
    check(velocity[2 if z_up else 1] < 0, f'{path}: the ball does not fall')
    check(len(values(cells, 'spin')) == len(kinds), f'{path}: there is no spin')
    return [(bounds[2 * a] + bounds[2 * a + 1]) / 2 for a in range(3)], velocity


# ---- Surfaces


def check_surfaces(folder, name, step, quantity):
    """VTP, PLY and OBJ have the same mesh for VTK and for meshio; the quantity is between its values of the particles."""
    own = vtp(f'{folder}/{name}_surface_{step:06}.vtp')
    ply = read(vtk.vtkPLYReader(), f'{folder}/{name}_{step:06}.ply')
    obj = read(vtk.vtkOBJReader(), f'{folder}/{name}_{step:06}.obj')
    corners = points(own)
    for other, tolerance in ((ply, 0), (obj, 1e-5)):
        check(other.GetNumberOfPoints() == len(corners) and other.GetNumberOfPolys() == own.GetNumberOfPolys() and
              all(near(a, b, tolerance) for a, b in zip(corners, points(other))), f'{name}: PLY or OBJ differs from VTP')
    check(open_edges(own) == 0, f'{name}: the surface is open')
    normals = own.GetPointData().GetNormals()
    check(normals is not None and normals.GetNumberOfTuples() == len(corners), f'{name}: the surface has no normals')
    check(own.GetPointData().GetScalars().GetName() == quantity, f'{name}: the surface has no {quantity}')
    colours = ply.GetPointData().GetArray('RGB')
    check(colours is not None and colours.GetNumberOfTuples() == len(corners), f'{name}: PLY has no colours for VTK')
    mesh = meshio.read(f'{folder}/{name}_{step:06}.ply')
    check(len(mesh.points) == len(corners) and all(near(a, b, 0) for a, b in zip(corners, mesh.points)),
          f'{name}: meshio reads another PLY')
    triangles = [cells.data for cells in mesh.cells if cells.type == 'triangle']
    check(sum(map(len, triangles)) == own.GetNumberOfPolys(), f'{name}: meshio reads other triangles')
    check(near(mesh.point_data[quantity], [v[0] for v in values(own.GetPointData(), quantity)], 0),
          f'{name}: meshio reads other values')
    # Some versions of meshio read bytes with a sign.
    for k, channel in enumerate(('red', 'green', 'blue')):
        check(near([int(v) % 256 for v in mesh.point_data[channel]], [colours.GetTuple(i)[k] for i in range(len(corners))], 0),
              f'{name}: meshio reads other colours')
    mesh = meshio.read(f'{folder}/{name}_{step:06}.obj')
    check(len(mesh.points) == len(corners) and all(near(a, b[:3], 1e-5) for a, b in zip(corners, mesh.points)),
          f'{name}: meshio reads another OBJ')
    return own


# ---- ParaView

PARAVIEW = '''
import sys
from paraview.simple import PVDReader
reader = PVDReader(FileName=sys.argv[1])
reader.UpdatePipeline(time=reader.TimestepValues[-1])
data = reader.GetDataInformation()
print(list(reader.TimestepValues), data.GetNumberOfPoints(), reader.PointData.GetNumberOfArrays())
'''


def check_paraview(path, times, count, arrays):
    pvpython = shutil.which('pvpython')
    if not pvpython:
        print('no pvpython here: ParaView itself is not asked')
        return
    with open('read_pvd.py', 'w') as file:
        file.write(PARAVIEW)
    said = subprocess.run([pvpython, 'read_pvd.py', path], capture_output=True, text=True).stdout.split('\n')[0]
    check(said == f'{times} {count} {arrays}', f'{path}: ParaView reads {said!r} instead of {times} {count} {arrays}')


# ---- All


def check_all():
    run('run', 'bowling-ball-small', '--steps', '4', '-o', 'ball.rlog')
    formats = 'vtp,csv,springs,solids,surface,ply,obj'
    run('export', 'ball.rlog', '-o', 'y', '--format', formats, '--every', '2', '--color', 'density')
    run('export', 'ball.rlog', '-o', 'z', '--format', formats, '--step', '4', '--color', 'density', '--up', 'z')
    thickening = ['id', 'position', 'velocity', 'density', 'pressure', 'derivative', 'stiffness', 'kappa']
    table, data = check_particles('ball', 'y', 4, thickening)
    upright, other = check_particles('ball', 'z', 4, thickening)
    for column in ('position', 'velocity', 'derivative'):
        check([turned(v) for v in table[column]] == upright[column], f'{column} is not turned')
    for column in ('density', 'stiffness', 'kappa'):
        check(table[column] == upright[column], f'{column} is turned')
    check_collection('y', 'ball', [0, 2, 4], .033)
    check_collection('y', 'ball_solids', [0, 2, 4], .033)
    check_springs('y/ball_springs_000004.vtp', table)
    check_springs('z/ball_springs_000004.vtp', upright)
    centre, velocity = check_solids('y/ball_solids_000004.vtp', False, 8)
    up_centre, up_velocity = check_solids('z/ball_solids_000004.vtp', True, 8)
    check(near(turned(centre), up_centre, 1e-4) and turned(velocity) == up_velocity, 'the ball is not turned')
    surface, up_surface = (check_surfaces(folder, 'ball', 4, 'density') for folder in 'yz')
    check(abs(volume(surface) / volume(up_surface) - 1) < 1e-4, 'the surface is not turned')
    least, most = surface.GetPointData().GetArray('density').GetRange()
    check(min(table['density']) <= least < most <= max(table['density']), 'the surface has densities of no particle')
    check_paraview('y/ball.pvd', [0.0, 0.066, 0.132], data.GetNumberOfPoints(), data.GetPointData().GetNumberOfArrays())

    # A world with materials, the middle of a step, and a world with temperatures.
    run('run', 'drop-pair', '--set', 'particles=400', '--steps', '2', '-o', 'pair.rlog')
    run('export', 'pair.rlog', '-o', 'y', '--format', 'vtp,csv', '--step', '2', '--stage', 'forces')
    os.rename('y/pair_000002_forces.vtp', 'y/pair_000002.vtp')
    os.rename('y/pair_000002_forces.csv', 'y/pair_000002.csv')
    table, _ = check_particles('pair', 'y', 2, thickening + ['material'])
    check(set(table['material']) == {0, 1}, 'the drops are not of two materials')
    run('run', 'melting-drop', '--set', 'particles=400', '--steps', '1', '-o', 'melting.rlog')
    run('export', 'melting.rlog', '-o', 'y', '--format', 'vtp,csv,surface,ply,obj', '--step', '1', '--color', 'viscosity')
    check_particles('melting', 'y', 1, ['id', 'position', 'velocity', 'density', 'pressure', 'temperature', 'viscosity',
                                        'shear_rate'])
    check_surfaces('y', 'melting', 1, 'viscosity')

    # The finder of problems finds one: a byte of the CSV is changed.
    found = len(problems)
    with open('y/melting_000001.csv') as file:
        lines = file.read().split('\n')
    lines[5] = lines[5].replace('1', '2')
    with open('y/melting_000001.csv', 'w') as file:
        file.write('\n'.join(lines))
    with contextlib.redirect_stdout(io.StringIO()):
        check_particles('melting', 'y', 1, [])
    noticed = len(problems) > found
    del problems[found:]
    check(noticed, 'a changed number is not noticed')

    run('bench', 'history', '--windows', '5', '--particles', '300', '--settle', '3', '--steps', '2', '--repetitions', '1',
        '--trace', 'trace.json')
    with open('trace.json') as file:
        events = json.load(file)['traceEvents']
    check({event['ph'] for event in events} == {'M', 'X'} and len(events) > 400, 'the trace has too few events')


with tempfile.TemporaryDirectory() as scratch:
    os.chdir(scratch)
    check_all()
    os.chdir('/')
sys.exit(1 if problems else 0)
