//! The serial line of the link: USART3 at 115200 baud, 8 bits, no parity.

use super::pins::Link;
use embassy_stm32::bind_interrupts;
use embassy_stm32::peripherals::USART3;
use embassy_stm32::usart::{BufferedInterruptHandler, BufferedUart, BufferedUartRx, BufferedUartTx, Config};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::mutex::Mutex;
use embedded_io_async::{Read, Write};
use static_cell::ConstStaticCell;

bind_interrupts!(struct Line { USART3 => BufferedInterruptHandler<USART3>; });

/// Bytes that wait in either direction: a frame of the link and a half.
const WAITING: usize = 512;

type Half<T> = Mutex<CriticalSectionRawMutex, Option<T>>;
static RX: Half<BufferedUartRx<'static>> = Mutex::new(None);
static TX: Half<BufferedUartTx<'static>> = Mutex::new(None);

/// Opens the line; without it [`read`] and [`write`] never end.
///
/// # Panics
/// When called a second time.
pub(super) fn start(link: Link) {
    static TO_SEND: ConstStaticCell<[u8; WAITING]> = ConstStaticCell::new([0; WAITING]);
    static RECEIVED: ConstStaticCell<[u8; WAITING]> = ConstStaticCell::new([0; WAITING]);
    let mut config = Config::default();
    config.baudrate = 115_200;
    let line = BufferedUart::new(link.uart, link.rx, link.tx, TO_SEND.take(), RECEIVED.take(), Line, config);
    if let Ok((to, from)) = line.map(BufferedUart::split)
        && let (Ok(mut tx), Ok(mut rx)) = (TX.try_lock(), RX.try_lock())
    {
        (*tx, *rx) = (Some(to), Some(from));
    }
}

/// Waits for bytes; how many came. None came where the line was disturbed: what is left of that frame has a wrong check.
pub async fn read(into: &mut [u8]) -> usize {
    match RX.lock().await.as_mut() {
        Some(rx) => rx.read(into).await.unwrap_or(0),
        None => core::future::pending().await,
    }
}

/// Waits until all bytes are on their way.
pub async fn write(bytes: &[u8]) {
    match TX.lock().await.as_mut() {
        // Its error type has no value for sending.
        Some(tx) => tx.write_all(bytes).await.unwrap_or(()),
        None => core::future::pending().await,
    }
}
