#!/bin/sh
# Install the package into a bare Debian, use it as a user would, and remove it again.
#
#   resources/installer/prove.sh dist/apd-viewer_*.deb FOLDER
#
# Needs root, and debootstrap, xvfb, xdotool, imagemagick and x11-apps on this machine; the bare Debian gets
# neither Python nor a compiler. Pictures, exports and a log are left in FOLDER. MIRROR names another mirror.
set -eu
package=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
# The same relative paths then lead to the same places here and in the bare Debian.
cd /
suite=${SUITE:-bookworm}
mirror=${MIRROR:-http://deb.debian.org/debian}
root=$folder/root
display=:${DISPLAY_NUMBER:-93}
user=1000:1000
home=/home/user

say() { printf '%s\n' "$*" | tee -a "$folder/log"; }
fail() { say "FAILED: $*"; exit 1; }
inside() { chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
as_user() { chroot --userspec=$user "$root" env -i PATH=/usr/bin:/bin HOME=$home LANG=C.UTF-8 "$@"; }
files() { (cd "$root" && find . -path ./proc -prune -o -path ./dev -prune -o -path ./tmp -prune -o -path ./var/log -prune \
    -o -path ./var/lib/dpkg -prune -o -path ./var/cache -prune -o -path "./home" -prune -o -print | sort); }
shown() { import -display "$display" -window root "$folder/$1.png"; }
mouse() { DISPLAY=$display xdotool "$@"; }
# Wait until a picture of the display has more than 2,000 colours, as a shaded surface has.
pictured() {
    for _ in $(seq 1200); do
        colours=$(import -display "$display" -window root -format %k info: 2>/dev/null || echo 0)
        [ "$colours" -gt 2000 ] && return
        sleep 0.1
    done
    fail "no picture in two minutes"
}

server=
window=
finish() {
    [ -z "$window" ] || kill "$window" 2>/dev/null || true
    [ -z "$server" ] || kill "$server" 2>/dev/null || true
    sleep 1
    for place in tmp/.X11-unix dev/pts dev/shm dev proc; do
        mountpoint -q "$root/$place" && umount -l "$root/$place" || true
    done
}
trap finish EXIT

: > "$folder/log"
[ -e "$folder/base" ] || debootstrap --variant=minbase "$suite" "$folder/base" "$mirror" > "$folder/debootstrap.log"
rm -rf "$root"
cp -a "$folder/base" "$root"
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
mount -t tmpfs tmpfs "$root/dev/shm"
mkdir -p "$root/tmp/.X11-unix"
Xvfb "$display" -screen 0 1600x1000x24 -ac >/dev/null 2>&1 &
server=$!
sleep 1
mount --bind tmp/.X11-unix "$root/tmp/.X11-unix"
inside useradd --create-home --uid 1000 user

say "== installation: dependencies, then dpkg -i"
inside apt-get update -qq
cp "$package" "$root/tmp/package.deb"
depends=$(dpkg-deb -f "$package" Depends)
inside apt-get satisfy -qq --yes --no-install-recommends "$depends" > "$folder/apt.log" 2>&1 || fail "dependencies"
inside sh -c '! ls /usr/bin/python3* /usr/bin/gcc* 2>/dev/null' || fail "the bare Debian has Python or a compiler"
files > "$folder/before"
inside dpkg -i tmp/package.deb >> "$folder/apt.log" 2>&1 || fail "dpkg -i"
say "$(inside apd-viewer --version), $(du -sm "$root/usr/lib/apd-viewer" | cut -f1) MB"
# numba does without TBB, and Qt without GTK.
missing=$(inside LD_LIBRARY_PATH=/usr/lib/apd-viewer/_internal sh -c 'cd /usr/lib/apd-viewer &&
    find . -name "*.so*" -type f ! -name libqgtk3.so -exec ldd {} + 2>/dev/null' |
    awk '/not found/ && !/libtbb/ { print $1 }' | sort -u)
[ -z "$missing" ] || fail "libraries are missing: $missing"

say "== a mesh on the command line: deformation, report, sweep, study"
samples=/usr/lib/apd-viewer/_internal/apd_viewer/resources
as_user apd-viewer deform $samples/bottle.obj --selection $samples/bottle.sel --twist 40deg \
    -o $home/twisted.obj --report $home/report.json --picture $home/twisted.png >> "$folder/log" || fail "deform"
as_user apd-viewer sweep $samples/bottle.obj --selection $samples/bottle.sel --twist 30deg --steps 3 \
    --methods exact -o $home/sweep >> "$folder/log" || fail "sweep"
as_user sh -c "cd $home && printf 'mesh,selection,motion\n$samples/bottle.obj,$samples/bottle.sel,twist 20deg\n' > plan.csv &&
    apd-viewer study plan.csv -o study" >> "$folder/log" 2>&1 || fail "study"
as_user apd-viewer thumbnail $samples/duck.obj $home/duck.png || fail "thumbnail"
for made in twisted.obj report.json twisted.png sweep/sweep.csv study/results.csv duck.png; do
    [ -s "$root$home/$made" ] || fail "$made is missing"
done
as_user APD_VIEWER_LANGUAGE=de apd-viewer --help | grep -q Fenster || fail "it does not speak German"
as_user apd-viewer desktop --install && fail "desktop --install was not refused" || true
[ -s "$root/usr/lib/apd-viewer/_internal/apd_viewer/manual/index.html" ] || fail "the manual is missing"
for file in applications/apd-viewer.desktop mime/packages/apd-viewer.xml thumbnailers/apd-viewer.thumbnailer \
    icons/hicolor/scalable/apps/apd-viewer.svg man/man1/apd-viewer.1.gz doc/apd-viewer/copyright; do
    [ -s "$root/usr/share/$file" ] || fail "$file is missing"
done

say "== the window: picture, drag, export, report"
as_user DISPLAY="$display" apd-viewer --clicked > "$folder/window.log" 2>&1 &
window=$!
pictured
sleep "${PATIENCE:-20}"  # kernels are loaded beside it
shown opened
mouse mousemove 317 419 click 1 sleep 1  # skips the tour
mouse mousemove 591 200 sleep 0.3 mousedown 1
for x in $(seq 595 5 700); do mouse mousemove "$x" $((200 + (x - 591) / 8)) sleep 0.03; done
sleep 2
shown dragging
mouse mouseup 1 sleep 3
shown dragged
mouse mousemove 500 600 key ctrl+e sleep 3
shown export
mouse type $home/dragged.obj
mouse key Return sleep 3
# A click, since without a window manager nobody gives the focus back.
mouse mousemove 150 650 click 1 sleep 1 key ctrl+shift+e sleep 3
shown report
mouse type $home/dragged.html
mouse key Return sleep 8
shown reported
for made in dragged.obj dragged.html; do
    [ -s "$root$home/$made" ] || fail "$made is missing"
done
cmp -s "$root$home/dragged.obj" "$root$samples/bottle.obj" && fail "the drag changed nothing"
kill "$window"
wait "$window" 2>/dev/null || true
window=
grep -i -e error -e traceback "$folder/window.log" && fail "the window has complained" || true
rm -rf "$folder/home"
cp -a "$root$home" "$folder/home"

say "== removal"
inside dpkg --purge apd-viewer >> "$folder/apt.log" 2>&1 || fail "purge"
files > "$folder/after"
diff "$folder/before" "$folder/after" >> "$folder/log" || fail "the removal has left files, or removed others"
say "nothing is left in the system; in the home, besides what was asked for:"
(cd "$root$home" && find . -mindepth 2 -maxdepth 2 -path './.*/*' | sort) | tee -a "$folder/log"
inside ls -A tmp | grep -v -e package.deb | sed 's/^/left in tmp: /' | tee -a "$folder/log"
say "ALL SHOWN"
