"""Run by test_command_resume.py in a Python of its own, with the bpy module: the command on the file named first."""

import sys

import bpy

import addon.blender
from addon.blender import command

addon.blender.register()
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
status = command.run(sys.argv[2:])
addon.blender.unregister()
sys.exit(status)
