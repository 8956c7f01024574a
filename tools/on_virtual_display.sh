#!/usr/bin/env bash
# Runs a command with a window on a virtual display of its own, and ends with the command's status.
#
#   tools/on_virtual_display.sh COMMAND...
#
# The server takes the first free number itself: several may be started at once.
set -u

exec {numbers}< <(exec Xvfb -displayfd 1 -screen 0 1280x1024x24 -nolisten tcp 2>/dev/null)
server=$!
trap 'kill "$server" 2>/dev/null' EXIT
if ! read -r -t 60 number <&"$numbers"; then
  echo "on_virtual_display: Xvfb (package xvfb) did not start" >&2
  exit 125
fi
DISPLAY=:$number "$@"
