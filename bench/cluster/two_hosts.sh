#!/usr/bin/env bash
# A bake by two hosts of one machine, over a network of a limited rate: what the exchanges take.
#
#   bench/cluster/two_hosts.sh RATE SCENE [options of luxel bake]     RATE: as tc has it, such as 100mbit
#
# As root, with iproute2 and Open MPI. The hosts are network namespaces with names of their own. Each
# works with one thread. Prints the seconds without a limit and with it, and what was exchanged.
set -euo pipefail
rate=$1 scene=$2
shift 2
luxel=$(realpath "${LUXEL:-build/release/bin/luxel}")
folder=$(mktemp -d)
clean_up() {
  ip netns del luxel-1 2>/dev/null || true
  ip netns del luxel-2 2>/dev/null || true
  rm -rf "$folder"
}
trap clean_up EXIT

ip netns add luxel-1
ip netns add luxel-2
ip link add veth-1 netns luxel-1 type veth peer name veth-2 netns luxel-2
for host in 1 2; do
  ip -n luxel-$host addr add 10.9.0.$host/24 dev veth-$host
  ip -n luxel-$host link set veth-$host up
  ip -n luxel-$host link set lo up
done

# What mpirun calls instead of ssh: HOST COMMAND...
cat >"$folder/on_host" <<'END'
#!/usr/bin/env bash
number=${1##*.}
shift
exec ip netns exec luxel-$number unshare -u bash -c "hostname luxel-$number; $*"
END
chmod +x "$folder/on_host"

# Prints the seconds of a bake, and what was exchanged.
bake() {
  "$folder/on_host" 10.9.0.1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
    mpirun --mca plm_rsh_agent "$folder/on_host" --mca oob_tcp_if_include 10.9.0.0/24 \
    --mca btl_tcp_if_include 10.9.0.0/24 --bind-to none -host 10.9.0.1:1,10.9.0.2:1 -n 2 \
    "$luxel" bake "$scene" -o "$folder/baked" --threads 1 --quiet "$@"
  python3 - "$folder/baked/bake.json" <<'END'
import json, sys
report = json.load(open(sys.argv[1]))
team = report["team"]
print(f"{report['seconds']['total']:.2f} s, {team['exchanges']} exchanges, {team['bytes'] / 1e6:.1f} MB")
END
}

echo "no limit: $(bake "$@")"
for host in 1 2; do
  ip netns exec luxel-$host tc qdisc add dev veth-$host root tbf rate "$rate" burst 128kb latency 100ms
done
echo "$rate: $(bake "$@")"
