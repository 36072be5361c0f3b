#!/bin/sh
# The batch tests on a processor with AVX-512, for those who have none: a Linux of a few files in Bochs, which emulates
# one. Says what is right, not what is fast. Usage: test/bench/avx512.sh [BUILD] (build/release); half an hour or more.
# Needs: apt install bochs bochsbios vgabios busybox-static isolinux syslinux-common xorriso cpio
set -eu
cd "$(dirname "$0")/../.."
project=$PWD
build=$(realpath "${1:-build/release}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

mkdir -p root/bin root/proc root/dev "root$project" iso
cp /bin/busybox root/bin/
cp "$build/test/test_property" root/bin/
cp -r "$project/datasets" "root$project/"
ldd root/bin/test_property | grep -o '/[^ ]*' | while read -r library; do
  mkdir -p "root$(dirname "$library")"
  cp -L "$library" "root$library"
done
cat > root/init <<'INIT'
#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t devtmpfs dev /dev
exec > /dev/ttyS0 2>&1
/bin/busybox grep -o -w -m 1 avx512f /proc/cpuinfo
/bin/test_property "batch: *" -d yes && echo "the tests passed" || echo "the tests failed"
/bin/busybox sleep 1
/bin/busybox poweroff -f
INIT
chmod +x root/init
(cd root && find . | cpio --quiet -o -H newc | gzip -1) > iso/initrd.gz

apt-get -qq download "$(apt-cache depends linux-image-cloud-amd64 | sed -n 's/ *Depends: \(linux-image.*\)/\1/p')"
dpkg -x linux-image-*.deb kernel
cp kernel/boot/vmlinuz-* iso/vmlinuz
cp /usr/lib/ISOLINUX/isolinux.bin /usr/lib/syslinux/modules/bios/ldlinux.c32 iso/
# Without xsaves: Bochs 2.7 states a size for its area that Linux rightly disbelieves.
cat > iso/isolinux.cfg <<'BOOT'
DEFAULT linux
LABEL linux
 KERNEL vmlinuz
 APPEND initrd=initrd.gz console=ttyS0 quiet mitigations=off tsc=reliable clearcpuid=xsaves,xsavec
BOOT
xorriso -as mkisofs -quiet -o disk.iso -b isolinux.bin -c boot.cat -no-emul-boot -boot-load-size 4 -boot-info-table iso

cat > bochsrc <<'MACHINE'
cpu: model=corei7_skylake_x, ips=50000000
memory: guest=1024, host=1024
romimage: file=/usr/share/bochs/BIOS-bochs-latest
vgaromimage: file=/usr/share/bochs/VGABIOS-lgpl-latest
ata0-master: type=cdrom, path=disk.iso, status=inserted
boot: cdrom
com1: enabled=1, mode=file, dev=serial
display_library: rfb, options="timeout=0"
log: log
MACHINE
printf 'c\nquit\n' > run  # Debian's Bochs is its debugger
bochs -q -f bochsrc -rc run > /dev/null 2>&1 < /dev/null || true
cat serial
grep -q avx512f serial && grep -q "the tests passed" serial
